"""The site of the documentation: how it is made of docs and of the code (`./doseki docs`)."""
