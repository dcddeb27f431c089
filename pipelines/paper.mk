# The source paper done again: its tables and figures beside ours, in reports/paper/index.html.
PAPER_OUT ?= reports/paper

.PHONY: paper
paper: $(PAPER_OUT)/index.html  ## compute the paper's tables and figures again, with a verdict for each

$(PAPER_OUT)/index.html: $(PROGRAM)
	$(TSAS) reproduce --out '$(PAPER_OUT)' $(STAGE)
