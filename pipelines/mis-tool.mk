# The public recordings of two cable-driven surgical instruments (docs/ingest.md says where they
# are from), from their files to a report each; works alone too: make -f pipelines/mis-tool.mk
ifndef STEPS
.DEFAULT_GOAL := mis-tool
include pipelines/setup.mk pipelines/recordings.mk
endif
TSAS_DATA ?= ../shared/data
MIS_TOOL_OUT ?= reports/mis-tool
mis_tool_out := $(call target,MIS_TOOL_OUT)
MIS_TOOL := L_4 pitch

.PHONY: mis-tool $(MIS_TOOL:%=mis-tool-%)
mis-tool: $(MIS_TOOL:%=mis-tool-%)  ## ingest, check, calibrate, simulate and report on the public recordings of mis-tool

$(MIS_TOOL:%=mis-tool-%): mis-tool-%: $(PROGRAM)
	+@test -d '$(call name,TSAS_DATA)/mis-tool' || { echo 'no recordings in $(TSAS_DATA)/mis-tool: set TSAS_DATA to the folder that holds mis-tool/ (docs/ingest.md says where to get it)' >&2; exit 2; }
	+@$(INGESTED) RAW='$(TSAS_DATA)/mis-tool/$*' MAP=datasets/maps/mis-tool.toml DATASET='$(MIS_TOOL_OUT)/$*/dataset' OUT='$(MIS_TOOL_OUT)/$*'

# What is learned on some recordings of one instrument predicts the others, and the other instrument;
# only each run's own preload and zeros are fitted to what is predicted. Where something gains and is not proven to be
# the cause, the model with it predicts.
AT_0.1_HZ := L_4_00,L_4_04,L_4_09
AT_0.5_HZ := L_4_40,L_4_44,L_4_49
UP_TO_HALF_LOAD := L_4_00,L_4_04,L_4_40,L_4_44
FULL_LOAD := L_4_09,L_4_49

$(mis_tool_out)/L_4/dataset/dataset.toml $(mis_tool_out)/L_4/calibrate/model.toml $(mis_tool_out)/L_4/diagnose/model-extended.toml: mis-tool-L_4 ;
$(mis_tool_out)/pitch/dataset/dataset.toml: mis-tool-pitch ;

# Folder, runs to learn from.
define learned
$(mis_tool_out)/$(1)/calibrate/model.toml: $(mis_tool_out)/L_4/dataset/dataset.toml $(PROGRAM)
	$$(TSAS) calibrate '$$(MIS_TOOL_OUT)/L_4/dataset' --runs $(2) --out '$$(MIS_TOOL_OUT)/$(1)/calibrate' --quiet $$(STAGE)

$(mis_tool_out)/$(1)/diagnose/model-extended.toml: $(mis_tool_out)/L_4/dataset/dataset.toml $(PROGRAM)
	$$(TSAS) diagnose '$$(MIS_TOOL_OUT)/L_4/dataset' --runs $(2) --out '$$(MIS_TOOL_OUT)/$(1)/diagnose' $$(STAGE)
endef

# Folder of the models, folder of the dataset, folder of the predictions, which runs.
define predicted
mis-tool-predict: $(mis_tool_out)/$(3)/predict.json

$(mis_tool_out)/$(3)/predict.json: $(mis_tool_out)/$(2)/dataset/dataset.toml $(mis_tool_out)/$(1)/calibrate/model.toml $(mis_tool_out)/$(1)/diagnose/model-extended.toml $(PROGRAM)
	$$(TSAS) predict '$$(MIS_TOOL_OUT)/$(1)/calibrate' "$$$$(ls '$$(MIS_TOOL_OUT)/$(1)/diagnose/model-stand-in.toml' 2> /dev/null || echo '$$(MIS_TOOL_OUT)/$(1)/diagnose/model-extended.toml')" '$$(MIS_TOOL_OUT)/$(2)/dataset' $(4) --out '$$(MIS_TOOL_OUT)/$(3)' --force
endef

.PHONY: mis-tool-predict
mis-tool-predict:  ## learn from some recordings of mis-tool, predict other speeds, loads and the other instrument
$(eval $(call learned,speeds,$(AT_0.1_HZ)))
$(eval $(call learned,loads,$(UP_TO_HALF_LOAD)))
$(eval $(call predicted,speeds,L_4,speeds/predict,--runs $(AT_0.5_HZ)))
$(eval $(call predicted,loads,L_4,loads/predict,--runs $(FULL_LOAD)))
$(eval $(call predicted,L_4,pitch,pitch/predict))
