# The public recordings of two cable-driven surgical instruments (docs/ingest.md says where they
# are from), from their files to a report each; works alone too: make -f pipelines/mis-tool.mk
TSAS_DATA ?= ../shared/data
MIS_TOOL := L_4 pitch

.PHONY: mis-tool $(MIS_TOOL:%=mis-tool-%)
mis-tool: $(MIS_TOOL:%=mis-tool-%)  ## ingest, check, calibrate, simulate and report on the public recordings of mis-tool

$(MIS_TOOL:%=mis-tool-%): mis-tool-%:
	@test -d '$(TSAS_DATA)/mis-tool' || { echo 'no recordings in $(TSAS_DATA)/mis-tool: set TSAS_DATA to the folder that holds mis-tool/ (docs/ingest.md says where to get it)' >&2; exit 2; }
	@$(MAKE) --no-print-directory -f Makefile setup
	.venv/bin/tsas ingest '$(TSAS_DATA)/mis-tool/$*' --map datasets/maps/mis-tool.toml --out 'reports/mis-tool/$*/dataset' --force
	@$(MAKE) --no-print-directory -f Makefile pipeline DATASET='reports/mis-tool/$*/dataset' OUT='reports/mis-tool/$*'
