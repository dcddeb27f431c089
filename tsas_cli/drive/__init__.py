"""The drive between motor and tendon: its transfer function, fitted and diagnosed."""
