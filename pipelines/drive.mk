# The worked case of docs/drive.md: the shipped recordings of a harmonic drive, and their page.
DRIVE := datasets/drive-chirp
DRIVE_OUT ?= reports/drive

.PHONY: drive
drive: $(DRIVE_OUT)/report.html  ## identify and diagnose the shipped drive, and report on it

$(DRIVE_OUT)/check/check.json: $(DRIVE)/dataset.toml $(PROGRAM)
	$(TSAS) check $(DRIVE) --out '$(DRIVE_OUT)/check' $(STAGE)

$(DRIVE_OUT)/identify/drive.toml: $(DRIVE)/dataset.toml $(PROGRAM)
	$(TSAS) identify-harmonic-drive $(DRIVE) --out '$(DRIVE_OUT)/identify' $(STAGE)

$(DRIVE_OUT)/report.html: $(DRIVE)/dataset.toml $(DRIVE_OUT)/check/check.json $(DRIVE_OUT)/identify/drive.toml $(PROGRAM)
	$(TSAS) report $(DRIVE) '$(DRIVE_OUT)/check' '$(DRIVE_OUT)/identify' --out $@ --force
