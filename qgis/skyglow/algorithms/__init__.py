"""The processing algorithms: one file each, on what they share in ``base``."""
