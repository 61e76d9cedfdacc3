"""Bodies that deform, alone and in water."""
