"""The LuGre chain without the product: its equations, tight references, and rival solvers."""
