# Every controller on the paper's rig, undisturbed and disturbed, and a page of how well each follows
# the wanted force.
#
# make track                                 half a minute
TRACK_OUT ?= reports/track
track_out := $(call target,TRACK_OUT)

.PHONY: track
track: $(track_out)/report.html  ## let every controller follow a wanted force on a simulated rig, and report

$(track_out)/compare/tracking.json: $(PROGRAM)
	$(TSAS) track --compare --out '$(TRACK_OUT)/compare' $(STAGE)

$(track_out)/report.html: $(track_out)/compare/tracking.json $(PROGRAM)
	$(TSAS) report '$(TRACK_OUT)/compare' --out '$@' --force
