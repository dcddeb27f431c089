# Every controller on the paper's rig, undisturbed and disturbed, and a page of how well each follows
# the wanted force.
#
# make track                                 half a minute
TRACK_OUT ?= reports/track

.PHONY: track
track: setup  ## let every controller follow a wanted force on a simulated rig, and report
	$(TSAS) track --compare --out '$(TRACK_OUT)/compare' --rrd --force
	$(TSAS) report '$(TRACK_OUT)/compare' --out '$(TRACK_OUT)/report.html' --force
