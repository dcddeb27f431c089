# The shipped simulated datasets, made again byte for byte by the virtual rig of the tests.
.PHONY: datasets
datasets: setup  ## make the shipped simulated datasets again
	@$(BIN)/python -m tests.rig.make_datasets
