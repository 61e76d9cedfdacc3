"""Bodies by their shapes: what each makes of its table [body.NAME]."""
