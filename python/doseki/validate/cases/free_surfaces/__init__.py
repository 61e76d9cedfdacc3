"""Dam breaks, drops and tanks at rest."""
