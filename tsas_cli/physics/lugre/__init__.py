"""The dynamic chain: lumps with mass, damping and bristles (LuGre friction), followed in time."""
