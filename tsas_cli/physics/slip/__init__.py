"""The slip chain: the distributed quasi-static model for any load and every effect."""
