"""What makes a part fail, as a rate: declared models, handbook sections, accelerations."""
