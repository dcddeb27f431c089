# The worked case of docs/drive.md: the shipped recordings of a harmonic drive, and their page.
.PHONY: drive
drive: setup  ## identify and diagnose the shipped drive, and report on it
	$(TSAS) check datasets/drive-chirp --out reports/drive/check --rrd --force
	$(TSAS) identify-harmonic-drive datasets/drive-chirp --out reports/drive/identify --rrd --force
	$(TSAS) report datasets/drive-chirp reports/drive/check reports/drive/identify --out reports/drive/report.html --force
