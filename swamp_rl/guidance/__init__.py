"""Guidance: where to steer next, as plain functions of what is measured."""
