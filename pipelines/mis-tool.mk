# The public recordings of two cable-driven surgical instruments (docs/ingest.md says where they
# are from), from their files to a report each; works alone too: make -f pipelines/mis-tool.mk
ifndef STEPS
.DEFAULT_GOAL := mis-tool
include pipelines/setup.mk pipelines/recordings.mk
endif
TSAS_DATA ?= ../shared/data
MIS_TOOL_OUT ?= reports/mis-tool
MIS_TOOL := L_4 pitch

.PHONY: mis-tool $(MIS_TOOL:%=mis-tool-%)
mis-tool: $(MIS_TOOL:%=mis-tool-%)  ## ingest, check, calibrate, simulate and report on the public recordings of mis-tool

$(MIS_TOOL:%=mis-tool-%): mis-tool-%: $(PROGRAM)
	+@test -d '$(TSAS_DATA)/mis-tool' || { echo 'no recordings in $(TSAS_DATA)/mis-tool: set TSAS_DATA to the folder that holds mis-tool/ (docs/ingest.md says where to get it)' >&2; exit 2; }
	+@$(INGESTED) RAW='$(TSAS_DATA)/mis-tool/$*' MAP=datasets/maps/mis-tool.toml DATASET='$(MIS_TOOL_OUT)/$*/dataset' OUT='$(MIS_TOOL_OUT)/$*'

# What is learned on some recordings of one instrument predicts the others, and the other instrument;
# only each run's own preload and zeros are fitted to what is predicted.
AT_0.1_HZ := L_4_00,L_4_04,L_4_09
AT_0.5_HZ := L_4_40,L_4_44,L_4_49
UP_TO_HALF_LOAD := L_4_00,L_4_04,L_4_40,L_4_44
FULL_LOAD := L_4_09,L_4_49

$(MIS_TOOL:%=$(MIS_TOOL_OUT)/%/dataset/dataset.toml): $(MIS_TOOL_OUT)/%/dataset/dataset.toml: mis-tool-% ;
$(MIS_TOOL_OUT)/L_4/calibrate/model.toml $(MIS_TOOL_OUT)/L_4/diagnose/model-extended.toml: mis-tool-L_4 ;

# Folder, runs to learn from.
define learned
$(MIS_TOOL_OUT)/$(1)/calibrate/model.toml: $(MIS_TOOL_OUT)/L_4/dataset/dataset.toml $(PROGRAM)
	$$(TSAS) calibrate $(MIS_TOOL_OUT)/L_4/dataset --runs $(2) --out $$(@D) --quiet $$(STAGE)

$(MIS_TOOL_OUT)/$(1)/diagnose/model-extended.toml: $(MIS_TOOL_OUT)/L_4/dataset/dataset.toml $(PROGRAM)
	$$(TSAS) diagnose $(MIS_TOOL_OUT)/L_4/dataset --runs $(2) --out $$(@D) $$(STAGE)
endef

# Folder of the models, dataset, beginning of the outputs' names, which runs.
define predicted
mis-tool-predict: $(3)nominal/simulation.json $(3)extended/simulation.json

$(3)nominal/simulation.json: $(2)/dataset.toml $(1)/calibrate/model.toml $(PROGRAM)
	$$(TSAS) simulate $(2) $(4) --fit-own --model $(1)/calibrate --out $$(@D) $$(STAGE)

$(3)extended/simulation.json: $(2)/dataset.toml $(1)/diagnose/model-extended.toml $(PROGRAM)
	$$(TSAS) simulate $(2) $(4) --fit-own --model $(1)/diagnose/model-extended.toml --out $$(@D) $$(STAGE)
endef

.PHONY: mis-tool-predict
mis-tool-predict:  ## learn from some recordings of mis-tool, predict other speeds, loads and the other instrument
$(eval $(call learned,speeds,$(AT_0.1_HZ)))
$(eval $(call learned,loads,$(UP_TO_HALF_LOAD)))
$(eval $(call predicted,$(MIS_TOOL_OUT)/speeds,$(MIS_TOOL_OUT)/L_4/dataset,$(MIS_TOOL_OUT)/speeds/,--runs $(AT_0.5_HZ)))
$(eval $(call predicted,$(MIS_TOOL_OUT)/loads,$(MIS_TOOL_OUT)/L_4/dataset,$(MIS_TOOL_OUT)/loads/,--runs $(FULL_LOAD)))
$(eval $(call predicted,$(MIS_TOOL_OUT)/L_4,$(MIS_TOOL_OUT)/pitch/dataset,$(MIS_TOOL_OUT)/pitch/by-L_4-))
