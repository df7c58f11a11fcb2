"""How kernels are compiled, kept and reached."""
