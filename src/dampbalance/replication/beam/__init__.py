"""What stepped-sine tables and a hammer's blow say of a bolted beam: laws of its joint, and a decay predicted."""
