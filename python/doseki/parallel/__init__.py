"""Runs on several ranks: who owns what (decomposition), and how ranks talk (transport, over MPI).

The compiled core packs and unpacks; everything that knows of MPI is in this folder.
"""
