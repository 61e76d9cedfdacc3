"""Runs in files of other programs: VTU, surfaces of what flows, and a scene for ParaView."""
