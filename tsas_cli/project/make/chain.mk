# From a dataset to a report: check, calibrate, simulate, diagnose, report. A step writes its folder
# whole or not at all, so that one file stands for all of it.
data := $(call target,DATASET)
made := $(call target,OUT)

.DEFAULT_GOAL = all
.PHONY: all
all: $(made)/report.html

# A stamp file whose name holds a digest of a step's arguments, so that a change is detected.
stamp = $(made)/.$(1)-$(shell printf %s $(call quoted,$(2)) | cksum | cut -d ' ' -f 1)
$(made)/.%:
	@mkdir -p '$(OUT)' && rm -f '$(OUT)'/.$(firstword $(subst -, ,$*))-* && touch '$@'

$(made)/check/check.json: $(data)/dataset.toml $(call stamp,check,$(DATASET) $(STAGE)) $(PROGRAM)
	$(TSAS) check '$(DATASET)' --out '$(OUT)/check' $(STAGE)

$(made)/calibrate/model.toml: $(data)/dataset.toml $(call stamp,calibrate,$(DATASET) $(CALIBRATE) $(STAGE)) $(PROGRAM)
	$(TSAS) calibrate '$(DATASET)' --out '$(OUT)/calibrate' $(CALIBRATE) $(STAGE)

$(made)/simulate/simulation.json: $(data)/dataset.toml $(made)/calibrate/model.toml $(call stamp,simulate,$(DATASET) $(SIMULATE) $(STAGE)) $(PROGRAM)
	$(TSAS) simulate '$(DATASET)' --model '$(OUT)/calibrate/model.toml' --out '$(OUT)/simulate' $(SIMULATE) $(STAGE)

$(made)/diagnose/diagnosis.json: $(data)/dataset.toml $(made)/calibrate/model.toml $(call stamp,diagnose,$(DATASET) $(DIAGNOSE) $(STAGE)) $(PROGRAM)
	$(TSAS) diagnose '$(DATASET)' --model '$(OUT)/calibrate/model.toml' --out '$(OUT)/diagnose' $(DIAGNOSE) $(STAGE)

$(made)/report.html: $(data)/dataset.toml $(made)/check/check.json $(made)/calibrate/model.toml $(made)/simulate/simulation.json $(made)/diagnose/diagnosis.json $(PROGRAM)
	$(TSAS) report '$(DATASET)' '$(OUT)/check' '$(OUT)/calibrate' '$(OUT)/simulate' '$(OUT)/diagnose' --out '$(OUT)/report.html' --force
