"""Recordings in MCAP, which Foxglove, Lichtblick and PlotJuggler open: schemas, channels, writer, reader.

Messages that Foxglove has a schema for use it; `recording.proto` has the others, and `recording.desc` is its
descriptor as protoc makes it. The libraries are those of the extra `mcap`. Files are opened by the callers.
"""
