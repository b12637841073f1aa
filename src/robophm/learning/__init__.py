"""What the field says: failures → rates, life data → distributions, wear → remaining life, costs → maintenance."""
