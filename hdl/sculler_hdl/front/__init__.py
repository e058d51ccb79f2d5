"""Sensor front ends: from the sensor's pins to the core's sample port."""
