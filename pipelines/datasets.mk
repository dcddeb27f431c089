# The shipped simulated datasets, made again byte for byte by the virtual rig.
.PHONY: datasets
datasets: setup  ## make the shipped simulated datasets again
	@$(BIN)/python -m tsas_studies.challenge.rig.make_datasets --out datasets
