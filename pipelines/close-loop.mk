# Does a better model track better? Hidden effects are recorded, diagnosed, and tracked with the
# nominal, the extended and the true model.
#
# make close-loop                            two minutes
CLOSE_LOOP_OUT ?= reports/close-loop

.PHONY: close-loop
close-loop: setup  ## hide effects in a rig, diagnose them, and track with the better model
	$(TSAS) close-loop --out '$(CLOSE_LOOP_OUT)' --force
