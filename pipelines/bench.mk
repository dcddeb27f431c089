# What has to be fast, measured on this machine; a table, and reports/bench/bench.json.
.PHONY: bench
bench: setup  ## measure what has to be fast
	@$(BIN)/python -m benchmarks --out reports/bench/bench.json
