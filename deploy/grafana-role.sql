-- A role that sees what deploy/grafana-fleet.json asks for, and neither tokens, ledgers nor reports.
-- Run it in the fleet's database once `robophm fleet` has made its tables: psql -d fleet -f deploy/grafana-role.sql
-- How it signs in is for pg_hba.conf, or ALTER ROLE grafana PASSWORD.
CREATE ROLE grafana LOGIN;
GRANT USAGE ON SCHEMA robophm_fleet TO grafana;
GRANT SELECT (number, name, site) ON robophm_fleet.robot TO grafana;
GRANT SELECT ON robophm_fleet.heard, robophm_fleet.epoch, robophm_fleet.day, robophm_fleet.newest, robophm_fleet.refused TO grafana;
ALTER ROLE grafana SET default_transaction_read_only = on;
