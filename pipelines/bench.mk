# What has to be fast, measured on this machine; a table, and reports/bench/bench.json.
#
# make bench                                 half an hour, most of it coverage
# make bench-compare OLD=a.json NEW=b.json   what got slower between two of them, beyond noise
.PHONY: bench bench-compare
bench: setup  ## measure what has to be fast
	@$(BIN)/python -m benchmarks --out reports/bench/bench.json

bench-compare: setup  ## what got slower: make bench-compare OLD=a.json NEW=b.json
	@test -n '$(OLD)' -a -n '$(NEW)' || { echo 'say which: make bench-compare OLD=a.json NEW=b.json' >&2; exit 2; }
	@$(BIN)/python -m benchmarks compare '$(OLD)' '$(NEW)'
