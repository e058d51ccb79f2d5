"""What each bus takes of an ECP5: area and clock rate of NAME_bus alone."""
