# The worked case of docs/drive.md: the shipped recordings of a harmonic drive, and their page.
DRIVE := datasets/drive-chirp
DRIVE_OUT ?= reports/drive
drive_out := $(call target,DRIVE_OUT)

.PHONY: drive
drive: $(drive_out)/report.html  ## identify and diagnose the shipped drive, and report on it

$(drive_out)/check/check.json: $(DRIVE)/dataset.toml $(PROGRAM)
	$(TSAS) check $(DRIVE) --out '$(DRIVE_OUT)/check' $(STAGE)

$(drive_out)/identify/drive.toml: $(DRIVE)/dataset.toml $(PROGRAM)
	$(TSAS) identify-harmonic-drive $(DRIVE) --out '$(DRIVE_OUT)/identify' $(STAGE)

$(drive_out)/report.html: $(DRIVE)/dataset.toml $(drive_out)/check/check.json $(drive_out)/identify/drive.toml $(PROGRAM)
	$(TSAS) report $(DRIVE) '$(DRIVE_OUT)/check' '$(DRIVE_OUT)/identify' --out '$@' --force
