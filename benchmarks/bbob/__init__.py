"""The 24 noiseless functions of BBOB (COCO), ours beside other libraries: see ``__main__``."""
