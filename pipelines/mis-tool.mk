# The public recordings of a cable-driven surgical instrument (docs/ingest.md says where they are
# from), from their files to a report; works alone too: make -f pipelines/mis-tool.mk
TSAS_DATA ?= ../shared/data

.PHONY: mis-tool
mis-tool:  ## ingest, check, calibrate, simulate and report on the public recordings of mis-tool
	@test -d '$(TSAS_DATA)/mis-tool' || { echo 'no recordings in $(TSAS_DATA)/mis-tool: set TSAS_DATA to the folder that holds mis-tool/ (docs/ingest.md says where to get it)' >&2; exit 2; }
	@$(MAKE) --no-print-directory -f Makefile setup
	.venv/bin/tsas ingest '$(TSAS_DATA)/mis-tool/L_4' '$(TSAS_DATA)/mis-tool/pitch' --map datasets/maps/mis-tool.toml --out reports/mis-tool/dataset --force
	@$(MAKE) --no-print-directory -f Makefile pipeline DATASET=reports/mis-tool/dataset OUT=reports/mis-tool
