"""Joints without an oscillator of their own, or of many sliders: tables of a stepped sine, gradual contacts."""

from .answer import damping_at as damping_at
from .answer import identify_joint as identify_joint
