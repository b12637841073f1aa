"""What a cut of power, a kill or a flipped bit may leave of what people keep, and that nothing is lost or made up."""
