# The source paper done again: its tables and figures beside ours, in reports/paper/index.html.
PAPER_OUT ?= reports/paper
paper_out := $(call target,PAPER_OUT)

.PHONY: paper
paper: $(paper_out)/index.html  ## compute the paper's tables and figures again, with a verdict for each

$(paper_out)/index.html: $(PROGRAM)
	$(TSAS) reproduce --out '$(PAPER_OUT)' --force
