# Public recordings that the project does not ship: what is learned from some of them predicts others,
# and docs/measured.md says how well. benchmarks/real/sources.toml lists them.
#
# make real                                  all that TSAS_DATA holds: hours
# make real REAL=mis-tool/speeds             one split, or all of a source: minutes
TSAS_DATA ?= ../shared/data
REAL_OUT ?= reports/real

.PHONY: real
real: $(PROGRAM)  ## learn from public recordings, predict others, and write the table of docs/measured.md
	@$(BIN)/python -m benchmarks.real $(if $(value REAL),'$(call name,REAL)') --data '$(call name,TSAS_DATA)' --out '$(call name,REAL_OUT)'
