# The public recordings of a banded friction damper (docs/ingest.md says where they are from): what
# is learned at 0.5 Hz predicts 1 Hz; works alone too: make -f pipelines/friction-damper.mk
ifndef STEPS
.DEFAULT_GOAL := friction-damper
include pipelines/setup.mk pipelines/recordings.mk
endif
TSAS_DATA ?= ../shared/data
DAMPER ?= reports/friction-damper
damper_out := $(call target,DAMPER)
DAMPER_LEARNED := 0.5Hz20lbtension,0.5Hz80lbtension
DAMPER_PREDICTED := 1Hz20lbtension,1Hz80lbtension

.PHONY: friction-damper friction-damper-dataset
friction-damper: $(damper_out)/report.html $(damper_out)/predict/predict.json  ## diagnose the public recordings of a friction damper at 0.5 Hz, predict those at 1 Hz

friction-damper-dataset: $(PROGRAM)
	+@test -d '$(call name,TSAS_DATA)/friction-damper' || { echo 'no recordings in $(TSAS_DATA)/friction-damper: set TSAS_DATA to the folder that holds friction-damper/ (docs/ingest.md says where to get it)' >&2; exit 2; }
	+@$(INGESTED) RAW='$(TSAS_DATA)/friction-damper' MAP=datasets/maps/friction-damper.toml DATASET='$(DAMPER)/dataset' OUT='$(DAMPER)' '$(DAMPER)/dataset/dataset.toml'

$(damper_out)/dataset/dataset.toml: friction-damper-dataset ;

$(damper_out)/calibrate/model.toml: $(damper_out)/dataset/dataset.toml $(PROGRAM)
	$(TSAS) calibrate '$(DAMPER)/dataset' --runs $(DAMPER_LEARNED) --out '$(DAMPER)/calibrate' $(STAGE)

$(damper_out)/diagnose/model-extended.toml: $(damper_out)/dataset/dataset.toml $(PROGRAM)
	$(TSAS) diagnose '$(DAMPER)/dataset' --runs $(DAMPER_LEARNED) --out '$(DAMPER)/diagnose' $(STAGE)

$(damper_out)/predict/predict.json: $(damper_out)/calibrate/model.toml $(damper_out)/diagnose/model-extended.toml $(PROGRAM)
	$(TSAS) predict '$(DAMPER)/calibrate' '$(DAMPER)/diagnose/model-extended.toml' '$(DAMPER)/dataset' --runs $(DAMPER_PREDICTED) --out '$(DAMPER)/predict' --force

$(damper_out)/report.html: $(damper_out)/diagnose/model-extended.toml $(damper_out)/predict/predict.json $(PROGRAM)
	$(TSAS) report '$(DAMPER)/dataset' '$(DAMPER)/diagnose' '$(DAMPER)/predict' --out '$@' --force
