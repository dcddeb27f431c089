"""The Rerun stream: what was measured and simulated, over time, to look at in the viewer."""
