# Does a better model track better? Hidden effects are recorded, diagnosed, and tracked with the
# nominal, the extended and the true model, and a page shows what that is worth.
#
# make close-loop                            three minutes
CLOSE_LOOP_OUT ?= reports/close-loop

.PHONY: close-loop
close-loop: setup  ## hide effects in a rig, diagnose them, track with the better model, and report
	$(TSAS) close-loop --out '$(CLOSE_LOOP_OUT)/loop' --rrd --force
	$(TSAS) report '$(CLOSE_LOOP_OUT)/loop' --out '$(CLOSE_LOOP_OUT)/report.html' --force
