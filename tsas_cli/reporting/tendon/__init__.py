"""The tendon drawn: its shape, what is along it, and when it is looked at; any picture uses it."""
