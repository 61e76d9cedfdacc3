"""Makes the pages of docs/gallery: scenarios that were run, and what is read of their records."""
