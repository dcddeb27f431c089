# The source paper done again: its tables and figures beside ours, in reports/paper/index.html.
.PHONY: paper
paper: setup  ## compute the paper's tables and figures again, with a verdict for each
	$(TSAS) reproduce --out reports/paper --force
