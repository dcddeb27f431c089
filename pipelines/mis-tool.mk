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

# What is learned on some recordings of one instrument predicts the others, and the other instrument;
# only each run's own preload and zeros are fitted to what is predicted.
MIS_TOOL_OUT := reports/mis-tool
AT_0.1_HZ := L_4_00,L_4_04,L_4_09
AT_0.5_HZ := L_4_40,L_4_44,L_4_49
UP_TO_HALF_LOAD := L_4_00,L_4_04,L_4_40,L_4_44
FULL_LOAD := L_4_09,L_4_49

# Folder, runs to learn from, runs to predict.
define predict
	.venv/bin/tsas calibrate $(MIS_TOOL_OUT)/L_4/dataset --runs $(2) --out $(MIS_TOOL_OUT)/$(1)/calibrate --rrd --force --quiet
	.venv/bin/tsas diagnose $(MIS_TOOL_OUT)/L_4/dataset --runs $(2) --out $(MIS_TOOL_OUT)/$(1)/diagnose --rrd --force
	.venv/bin/tsas simulate $(MIS_TOOL_OUT)/L_4/dataset --runs $(3) --fit-own --model $(MIS_TOOL_OUT)/$(1)/calibrate --out $(MIS_TOOL_OUT)/$(1)/nominal --rrd --force
	.venv/bin/tsas simulate $(MIS_TOOL_OUT)/L_4/dataset --runs $(3) --fit-own --model $(MIS_TOOL_OUT)/$(1)/diagnose/model-extended.toml --out $(MIS_TOOL_OUT)/$(1)/extended --rrd --force
endef

.PHONY: mis-tool-predict
mis-tool-predict: mis-tool  ## learn from some recordings of mis-tool, predict other speeds, loads and the other instrument
	$(call predict,speeds,$(AT_0.1_HZ),$(AT_0.5_HZ))
	$(call predict,loads,$(UP_TO_HALF_LOAD),$(FULL_LOAD))
	.venv/bin/tsas simulate $(MIS_TOOL_OUT)/pitch/dataset --fit-own --model $(MIS_TOOL_OUT)/L_4/calibrate --out $(MIS_TOOL_OUT)/pitch/by-L_4-nominal --rrd --force
	.venv/bin/tsas simulate $(MIS_TOOL_OUT)/pitch/dataset --fit-own --model $(MIS_TOOL_OUT)/L_4/diagnose/model-extended.toml --out $(MIS_TOOL_OUT)/pitch/by-L_4-extended --rrd --force
