# From a dataset to a report: check, calibrate, simulate, diagnose, report.
#
# make run                                   on the shipped recordings
# make pipeline DATASET=folder OUT=folder    on your own
TSAS = $(BIN)/tsas

.PHONY: run pipeline
run: DATASET = datasets/paper-groups
run: OUT = reports/run
run: pipeline  ## check, calibrate, simulate, diagnose and report on the shipped recordings

pipeline: setup  ## the same on your own: make pipeline DATASET=folder OUT=folder
	@test -n '$(DATASET)' -a -n '$(OUT)' || { echo 'say on what and where to: make pipeline DATASET=folder OUT=folder' >&2; exit 2; }
	$(TSAS) check '$(DATASET)' --out '$(OUT)/check' --rrd --force
	$(TSAS) calibrate '$(DATASET)' --out '$(OUT)/calibrate' --rrd --force
	$(TSAS) simulate '$(DATASET)' --model '$(OUT)/calibrate/model.toml' --out '$(OUT)/simulate' --rrd --force
	$(TSAS) diagnose '$(DATASET)' --model '$(OUT)/calibrate/model.toml' --out '$(OUT)/diagnose' --rrd --force
	$(TSAS) report '$(DATASET)' '$(OUT)/check' '$(OUT)/calibrate' '$(OUT)/simulate' '$(OUT)/diagnose' --out '$(OUT)/report.html' --force
