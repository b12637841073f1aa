// A peer of another make: Fast DDS, with types written by hand. Reads commands, a line each, and says what it hears.
// Everything is on loopback. Build: g++ -std=c++17 fastdds_peer.cpp -lfastrtps -lfastcdr (of Fast DDS 3, -lfastdds).
//
//   writer NAME TOPIC TYPE reliable|besteffort latched|volatile [USER-DATA]      says made
//   reader NAME TOPIC TYPE reliable|besteffort latched|volatile                  says made, then NAME and what it hears
//   matched NAME COUNT                                    says matched when it has so many of the others
//   float64 NAME VALUE     temperature NAME SECONDS NANOSECONDS FRAME TEMPERATURE VARIANCE     turned: big-endian
//   count NAME NUMBER      so many temperatures, numbered; says sent
//   raw NAME HEX           these bytes     close NAME     says closed
#include <atomic>
#include <chrono>
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <iomanip>
#include <iostream>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>

#if __has_include(<fastdds/utils/IPLocator.hpp>) // version 3
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
namespace rtps = eprosima::fastdds::rtps;
const auto FINE = eprosima::fastdds::dds::RETCODE_OK;
const auto SENT = FINE;
const auto PLAIN = eprosima::fastcdr::CdrVersion::DDS_CDR;
#define HEARTBEAT heartbeat_period
#define WRITTEN get_serialized_data_length
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
namespace rtps = eprosima::fastrtps::rtps;
const auto FINE = eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
const auto SENT = true;
const auto PLAIN = eprosima::fastcdr::Cdr::DDS_CDR;
#define HEARTBEAT heartbeatPeriod
#define WRITTEN getSerializedDataLength
#define BEFORE_3
#endif

using namespace eprosima::fastdds::dds;
using rtps::SerializedPayload_t;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;
using Bytes = std::vector<char>;

// Carries bytes that are CDR already, encapsulation included: what is in them is the business of the commands.
class Carrier : public TopicDataType {
  public:
#ifdef BEFORE_3
    explicit Carrier(const std::string &name) {
        setName(name.c_str());
        m_typeSize = 1 << 20;
        m_isGetKeyDefined = false;
    }
    bool serialize(void *data, SerializedPayload_t *payload) override { return written(data, *payload); }
    bool deserialize(SerializedPayload_t *payload, void *data) override { return read(*payload, data); }
    std::function<uint32_t()> getSerializedSizeProvider(void *data) override {
        return [data] { return size(data); };
    }
    void *createData() override { return new Bytes; }
    void deleteData(void *data) override { delete static_cast<Bytes *>(data); }
    bool getKey(void *, rtps::InstanceHandle_t *, bool) override { return false; }
#else
    explicit Carrier(const std::string &name) {
        set_name(name);
        max_serialized_type_size = 1 << 20;
        is_compute_key_provided = false;
    }
    bool serialize(const void *data, SerializedPayload_t &payload, DataRepresentationId_t) override {
        return written(data, payload);
    }
    bool deserialize(SerializedPayload_t &payload, void *data) override { return read(payload, data); }
    uint32_t calculate_serialized_size(const void *data, DataRepresentationId_t) override { return size(data); }
    void *create_data() override { return new Bytes; }
    void delete_data(void *data) override { delete static_cast<Bytes *>(data); }
    bool compute_key(SerializedPayload_t &, rtps::InstanceHandle_t &, bool) override { return false; }
    bool compute_key(const void *, rtps::InstanceHandle_t &, bool) override { return false; }
#endif

  private:
    static uint32_t size(const void *data) { return uint32_t(static_cast<const Bytes *>(data)->size()); }
    static bool written(const void *data, SerializedPayload_t &payload) {
        auto *bytes = static_cast<const Bytes *>(data);
        if (bytes->size() > payload.max_size)
            return false;
        payload.length = bytes->size();
        payload.encapsulation = (*bytes)[1] ? CDR_LE : CDR_BE;
        memcpy(payload.data, bytes->data(), bytes->size());
        return true;
    }
    static bool read(SerializedPayload_t &payload, void *data) {
        static_cast<Bytes *>(data)->assign(payload.data, payload.data + payload.length);
        return true;
    }
};

struct Temperature {
    int32_t seconds = 0;
    uint32_t nanoseconds = 0;
    std::string frame;
    double temperature = 0, variance = 0;
};

std::mutex speaking;

void say(const std::string &line) {
    std::lock_guard<std::mutex> lock(speaking);
    std::cout << line << std::endl;
}

Bytes written(Cdr::Endianness order, const std::function<void(Cdr &)> &fill) {
    Bytes room(4096);
    FastBuffer buffer(room.data(), room.size());
    Cdr cdr(buffer, order, PLAIN);
    cdr.serialize_encapsulation();
    fill(cdr);
    room.resize(cdr.WRITTEN());
    return room;
}

Bytes bytes_of(const Temperature &t, Cdr::Endianness order = Cdr::LITTLE_ENDIANNESS) {
    return written(order, [&](Cdr &cdr) {
        cdr << t.seconds << t.nanoseconds << t.frame << t.temperature << t.variance;
    });
}

class Ear : public DataReaderListener {
  public:
    Ear(std::string name, std::string type) : name_(std::move(name)), type_(std::move(type)) {}
    void on_data_available(DataReader *reader) override {
        Bytes bytes;
        SampleInfo info;
        while (reader->take_next_sample(&bytes, &info) == FINE)
            if (info.valid_data)
                heard(bytes);
    }

  private:
    void heard(Bytes &bytes) {
        std::ostringstream line;
        line << std::setprecision(17) << name_;
        FastBuffer buffer(bytes.data(), bytes.size());
        Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, PLAIN);
        cdr.read_encapsulation();
        if (type_ == "std_msgs::msg::dds_::Float64_") {
            double value;
            cdr >> value;
            line << " " << value;
        } else if (type_ == "sensor_msgs::msg::dds_::Temperature_") {
            Temperature t;
            cdr >> t.seconds >> t.nanoseconds >> t.frame >> t.temperature >> t.variance;
            line << " " << t.seconds << " " << t.nanoseconds << " " << t.frame << " " << t.temperature << " "
                 << t.variance;
        } else {
            line << " " << bytes.size();
        }
        say(line.str());
    }
    std::string name_, type_;
};

int main(int, char **arguments) {
    DomainParticipantQos qos;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    udp->maxInitialPeersRange = 8;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    rtps::Locator_t loopback;
    rtps::IPLocator::setIPv4(loopback, 127, 0, 0, 1);
    qos.wire_protocol().builtin.initialPeersList.push_back(loopback);
    auto *participant = DomainParticipantFactory::get_instance()->create_participant(std::stoi(arguments[1]), qos);
    if (!participant)
        return 1;
    auto *publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
    auto *subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    std::map<std::string, DataWriter *> writers;
    std::map<std::string, DataReader *> readers;
    std::map<std::string, Topic *> topics;

    auto topic_of = [&](const std::string &name, const std::string &type) {
        TypeSupport(new Carrier(type)).register_type(participant);
        if (topics.count(name) && topics[name]->get_type_name() != type) {
            participant->delete_topic(topics[name]);
            topics.erase(name);
        }
        if (!topics.count(name))
            topics[name] = participant->create_topic(name, type, TOPIC_QOS_DEFAULT);
        return topics[name];
    };
    say("ready");
    std::string text;
    while (std::getline(std::cin, text)) {
        std::istringstream line(text);
        std::string command, name;
        line >> command >> name;
        auto send = [&](Bytes bytes) {
            if (writers.at(name)->write(&bytes) != SENT)
                say("not sent");
        };
        if (command == "writer" || command == "reader") {
            std::string topic, type, reliability, durability, user_data;
            line >> topic >> type >> reliability >> durability >> user_data;
            auto reliable = reliability == "reliable" ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
            auto latched = durability == "latched" ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
            if (command == "writer") {
                DataWriterQos w;
                w.reliability().kind = reliable;
                w.durability().kind = latched;
                w.history().kind = durability == "latched" ? KEEP_LAST_HISTORY_QOS : KEEP_ALL_HISTORY_QOS;
                w.history().depth = 1;
                w.publish_mode().kind = SYNCHRONOUS_PUBLISH_MODE;
                w.reliable_writer_qos().times.HEARTBEAT = {0, 50 * 1000 * 1000};
                w.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
                w.user_data().setValue(std::vector<uint8_t>(user_data.begin(), user_data.end()));
                writers[name] = publisher->create_datawriter(topic_of(topic, type), w);
            } else {
                DataReaderQos r;
                r.reliability().kind = reliable;
                r.durability().kind = latched;
                r.history().kind = KEEP_ALL_HISTORY_QOS;
                r.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
                readers[name] = subscriber->create_datareader(topic_of(topic, type), r, new Ear(name, type));
            }
            say("made");
        } else if (command == "matched") {
            int wanted = 0;
            line >> wanted;
            int count;
            do {
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
                if (writers.count(name)) {
                    PublicationMatchedStatus status;
                    writers[name]->get_publication_matched_status(status);
                    count = status.current_count;
                } else {
                    SubscriptionMatchedStatus status;
                    readers.at(name)->get_subscription_matched_status(status);
                    count = status.current_count;
                }
            } while (count != wanted);
            say("matched");
        } else if (command == "float64") {
            double value;
            line >> value;
            send(written(Cdr::LITTLE_ENDIANNESS, [&](Cdr &cdr) { cdr << value; }));
        } else if (command == "temperature" || command == "turned") {
            Temperature t;
            line >> t.seconds >> t.nanoseconds >> t.frame >> t.temperature >> t.variance;
            send(bytes_of(t, command == "turned" ? Cdr::BIG_ENDIANNESS : Cdr::LITTLE_ENDIANNESS));
        } else if (command == "count") {
            int number;
            line >> number;
            for (int n = 0; n < number; ++n) {
                Temperature t;
                t.temperature = n;
                send(bytes_of(t));
            }
            say("sent");
        } else if (command == "raw") {
            std::string hex;
            Bytes bytes;
            line >> hex;
            for (size_t at = 0; at + 1 < hex.size(); at += 2)
                bytes.push_back(char(std::stoi(hex.substr(at, 2), nullptr, 16)));
            send(bytes);
        } else if (command == "close") {
            if (writers.count(name)) {
                publisher->delete_datawriter(writers[name]);
                writers.erase(name);
            }
            say("closed");
        }
    }
    participant->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant);
}
