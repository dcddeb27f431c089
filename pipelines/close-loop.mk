# Does a better model track better? Hidden effects are recorded, diagnosed, and tracked with the
# nominal, the extended and the true model, and a page shows what that is worth.
#
# make close-loop                            three minutes
CLOSE_LOOP_OUT ?= reports/close-loop
close_loop_out := $(call target,CLOSE_LOOP_OUT)

.PHONY: close-loop
close-loop: $(close_loop_out)/report.html  ## hide effects in a rig, diagnose them, track with the better model, and report

$(close_loop_out)/loop/closing.json: $(PROGRAM)
	$(TSAS) close-loop --out '$(CLOSE_LOOP_OUT)/loop' $(STAGE)

$(close_loop_out)/report.html: $(close_loop_out)/loop/closing.json $(PROGRAM)
	$(TSAS) report '$(CLOSE_LOOP_OUT)/loop' --out '$@' --force
