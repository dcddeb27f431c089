"""Two models, or what two stages wrote about them, side by side."""
