# What has to be fast, measured on this machine; a table, and reports/bench/bench.json.
#
# make bench                                 half an hour, most of it coverage
# make bench-compare OLD=a.json NEW=b.json   what got slower between two of them, beyond noise
.PHONY: bench bench-compare
bench: setup  ## measure what has to be fast
	@$(BIN)/python -m benchmarks --out reports/bench/bench.json

bench-compare: setup  ## what got slower: make bench-compare OLD=a.json NEW=b.json
	@$(BIN)/python -m benchmarks compare '$(call name,OLD)' '$(call name,NEW)'

# One recording of 1, 10 and 100 million rows through ingest, check, calibrate and simulate: time and
# memory. The largest takes 20 GB of disk (in BIG) and some hours.
BIG ?= reports/big
BIG_ROWS ?= 1e6,1e7,1e8
.PHONY: big
big: setup  ## take recordings too long for memory through every stage
	@mkdir -p '$(call name,BIG)'
	@TSAS_BIG='$(BIG)' TSAS_ROWS=$(BIG_ROWS) $(BIN)/python -m benchmarks out_of_core --out reports/bench/big.json
