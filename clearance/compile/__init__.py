"""How kernels become machine code: declared, compiled when the package is built, loaded and called."""
