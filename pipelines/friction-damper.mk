# The public recordings of a banded friction damper (docs/ingest.md says where they are from): what
# is learned at 0.5 Hz predicts 1 Hz; works alone too: make -f pipelines/friction-damper.mk
TSAS_DATA ?= ../shared/data
DAMPER := reports/friction-damper

.PHONY: friction-damper
friction-damper:  ## diagnose the public recordings of a friction damper at 0.5 Hz, predict those at 1 Hz
	@test -d '$(TSAS_DATA)/friction-damper' || { echo 'no recordings in $(TSAS_DATA)/friction-damper: set TSAS_DATA to the folder that holds friction-damper/ (docs/ingest.md says where to get it)' >&2; exit 2; }
	@$(MAKE) --no-print-directory -f Makefile setup
	.venv/bin/tsas ingest '$(TSAS_DATA)/friction-damper' --map datasets/maps/friction-damper.toml --out $(DAMPER)/dataset --force
	.venv/bin/tsas calibrate $(DAMPER)/dataset --runs 0.5Hz20lbtension,0.5Hz80lbtension --out $(DAMPER)/calibrate --rrd --force
	.venv/bin/tsas diagnose $(DAMPER)/dataset --runs 0.5Hz20lbtension,0.5Hz80lbtension --out $(DAMPER)/diagnose --rrd --force
	.venv/bin/tsas simulate $(DAMPER)/dataset --runs 1Hz20lbtension,1Hz80lbtension --fit-own --model $(DAMPER)/calibrate --out $(DAMPER)/nominal --rrd --force
	.venv/bin/tsas simulate $(DAMPER)/dataset --runs 1Hz20lbtension,1Hz80lbtension --fit-own --model $(DAMPER)/diagnose/model-extended.toml --out $(DAMPER)/extended --rrd --force
	.venv/bin/tsas report $(DAMPER)/dataset $(DAMPER)/diagnose --out $(DAMPER)/report.html --force
