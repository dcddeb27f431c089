# Every controller on the paper's rig, undisturbed and disturbed, and a page of how well each follows
# the wanted force.
#
# make track                                 half a minute
TRACK_OUT ?= reports/track

.PHONY: track
track: $(TRACK_OUT)/report.html  ## let every controller follow a wanted force on a simulated rig, and report

$(TRACK_OUT)/compare/tracking.json: $(PROGRAM)
	$(TSAS) track --compare --out '$(TRACK_OUT)/compare' $(STAGE)

$(TRACK_OUT)/report.html: $(TRACK_OUT)/compare/tracking.json $(PROGRAM)
	$(TSAS) report '$(TRACK_OUT)/compare' --out $@ --force
