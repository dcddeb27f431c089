# The documentation: its site, built offline, and its examples, run and filled in again.
.PHONY: docs docs-examples docs-refill
docs: setup  ## build the documentation's site in reports/docs/
	@$(BIN)/python -m docs.manual --out reports/docs

docs-examples: setup  ## run every example of the documentation, the long ones too, and say what differs
	@$(BIN)/python -m docs.examples --long

docs-refill: setup  ## write what the examples print now into the pages, and draw the pictures again
	@$(BIN)/python -m docs.examples --long --refill
	@$(BIN)/python -m docs.before_after
	@$(BIN)/python -m docs.house
