"""The whole method: problem -> contacts in place -> solution space -> fit -> proved surface."""
