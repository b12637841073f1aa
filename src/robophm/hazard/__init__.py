"""What makes a part fail, as a rate: models, handbooks, accelerations."""
