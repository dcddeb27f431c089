"""The sections of the page, one file each: a function from the inputs to what is shown."""
